"""`nocturne --help` in groups by purpose, each command with a line of at most 60 letters."""

import typer
from typer.models import CommandInfo, TyperInfo

PANELS: dict[str, dict[str, str]] = {
    "Render here": {
        "render": "Render a scene on this machine, without a service",
        "preflight": "Show what each part of a scene changes and costs",
        "annual": "Measure a year of daylight: sDA, ASE, with intervals",
    },
    "Render on a service": {
        "up": "Run a service on this machine until Ctrl-C",
        "down": "Stop the service that runs on a data folder",
        "demo": "Start a service if none answers, and render a first scene",
        "submit": "Upload a scene and start rendering; prints its id",
        "watch": "Follow a render to its end",
        "list": "List renders, newest first",
        "top": "Follow all open renders and all workers",
        "get": "Show a render; download images; read pixels",
        "group": "Show the renders of a group, together and each",
    },
    "Change a render": {
        "extend": "Add samples, or change stop conditions, also after the end",
        "pause": "Pause a render until it is resumed",
        "resume": "Go on with a paused or degraded render",
        "cancel": "Stop a render; its samples stay",
        "delete": "Delete a render and its files",
        "priority": "Change the share of the workers that a render gets",
        "tag": "Give a render words to find it by",
        "replay": "Trace a render again, to the same bits",
        "explain": "Say in one sentence what a render waits for",
    },
    "Images and light": {
        "measure": "Min, mean, max, U0, Ud of parts of an image, with errors",
        "glare": "UGR and DGP of a panorama or fisheye",
        "ugr": "Print the UGR table of a luminaire (CIE 117, CIE 190)",
        "year": "A year of daylight that a service traced: sDA, ASE",
        "point": "All illuminances at the point of a panorama",
        "report": "Report on the light of a room; is a requirement met?",
        "mix": "Dim light groups of an image; nothing is traced",
        "compare": "Test whether two images differ by more than noise",
        "baseline": "Compare a render with one by another engine",
        "ies": "Write an image of intensities as an IES, LDT or TM-33 file",
        "goniometer": "Measure a lamp in a scene: a photometric file with errors",
        "rays": "Write a lamp in a scene as a ray file (IES TM-25)",
        "validate": "Render scenes with known readings; say how far off they are",
    },
    "Scenes": {
        "import": "Make a document of a Mitsuba, pbrt, glTF, Radiance scene",
        "export": "Write a scene document for Mitsuba 3 or pbrt-v4",
        "compile": "Compile a scene for nocturne-trace",
        "openjd": "Write a render as a job for another queue (OpenJD)",
        "join": "Join the parts of such a job to its image",
    },
    "Administration": {
        "workers": "List workers, and why any of them is idle",
        "usage": "Show shares of the workers by owner, and cost",
        "token": "Make, list and revoke API tokens",
        "webhook": "Tell an address how your renders end",
        "restore": "Examine a data folder after a disaster, and repair it",
        "database": "Put the database of a new data folder on a server",
        "doctor": "List what this machine or a service lacks",
    },
}


def arrange(app: typer.Typer) -> None:
    """Puts all commands of the program into their panels, in this order."""
    order = [name for panel in PANELS.values() for name in panel]
    for panel, lines in PANELS.items():
        named: list[CommandInfo | TyperInfo] = [*app.registered_commands, *app.registered_groups]
        for each in named:
            name = _name(each)
            if name in lines:
                each.rich_help_panel = panel
                each.short_help = lines[name]
    app.registered_commands.sort(key=lambda each: order.index(_name(each)))


def _name(command: CommandInfo | TyperInfo) -> str:
    if command.name:
        return str(command.name)
    if isinstance(command, TyperInfo):
        return str(command.typer_instance.info.name) if command.typer_instance else ""
    return command.callback.__name__ if command.callback else ""
