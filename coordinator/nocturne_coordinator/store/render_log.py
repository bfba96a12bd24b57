"""What happened to one render, line by line: who asked what of it, how it went on, which tiles failed."""

import json
import time

from nocturne_coordinator.store.data_folder import DataFolder


def log_of(folder: DataFolder, render_id: str) -> str:
    """Oldest first, times in UTC. Raises NotFound."""
    render = folder.renders.get(render_id)
    lines = [(render.created, f"created: {render.width} x {render.height}, {render.samples} samples")]
    calls = folder.database.rows(
        "SELECT unix_time, who, what, outcome FROM call WHERE render_id = ?", (render_id,)
    )
    for call in calls:
        who = f" by {call['who']}" if call["who"] else ""
        lines.append((call["unix_time"], f"{call['what']}{who}: {call['outcome']}"))
    lines += [(time_of, what) for time_of, what in ((render.started, "started"),) if time_of]
    history = folder.renders.error_history(render_id)
    # A thousand points say no more than forty.
    for point in history[:: max(1, len(history) // 40)]:
        samples = f"{point.samples:.4g} samples a pixel"
        lines.append((point.unix_time, f"{samples}, relative error {point.relative_error:.3%}"))
    if render.ended:
        lines.append((render.ended, f"{render.state}: {render.reason}".rstrip(": ")))
    shown = [f"{_utc(at)}  {what}" for at, what in sorted(lines)]
    failed = folder.database.rows("SELECT * FROM failed_tile WHERE render_id = ?", (render_id,))
    for tile in failed:
        workers = ", ".join(json.loads(tile["workers"]))
        shown.append(f"tile {tile['tile_index']} failed on {workers}: {tile['reason']}")
    notes = [*(each.sentence for each in render.warnings), render.error_warning, render.target_unreachable]
    return "\n".join([*shown, *(f"note: {note}" for note in notes if note), ""])


def _utc(unix_time: float) -> str:
    return time.strftime("%Y-%m-%d %H:%M:%S", time.gmtime(unix_time))
