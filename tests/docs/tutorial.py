"""Turns the shell blocks of a tutorial into one script, as a reader would type them.

A block starts with one of these lines, of which a reader sees no more than the language:

```sh                    typed and waited for
```sh background NAME    one command in a separate shell, after what it exports, until its end or Ctrl-C
```sh skip               needs programs that this machine may not have

The comment `<!-- run: stop NAME -->` stands for Ctrl-C in a shell of that name.
"""

import re
from collections.abc import Mapping

_STEP = re.compile(
    r"^```sh(?P<words>[^\n]*)\n(?P<code>.*?)^```$|^<!-- run: stop (?P<stopped>\w+) -->$",
    re.MULTILINE | re.DOTALL,
)

_HEAD = """\
set -euo pipefail
LOGIN_PATH=$PATH
trap 'kill $(jobs -p) 2>/dev/null || true; wait' EXIT
wait_for_port() {
    for _ in $(seq 600); do
        if (exec 3<>"/dev/tcp/127.0.0.1/$1") 2>/dev/null; then return; fi
        sleep 0.1
    done
    echo "nothing listens on port $1" >&2
    exit 1
}
"""


def script_of(page: str, ports: Mapping[str, str]) -> str:
    """The script; `ports` says which others stand for those that the page names."""
    parts = [_HEAD]
    for number, step in enumerate(_STEP.finditer(page)):
        if step["stopped"]:
            parts.append(f'kill -INT "${step["stopped"]}"; wait "${step["stopped"]}" || true\n')
            continue
        words = step["words"].split()
        code = step["code"]
        if words[:1] == ["background"]:
            parts.append(_in_background(code, words[1] if words[1:] else f"shell{number}", ports))
        elif words != ["skip"]:
            assert words == [], f"a block with words that mean nothing: {words}"
            parts.append(code)
    script = "".join(parts)
    for told, free in ports.items():
        script = re.sub(rf"\b{told}\b", free, script)
    return script


def _in_background(code: str, name: str, ports: Mapping[str, str]) -> str:
    """Starts one command, and waits until something answers at each port that it names."""
    waits = "".join(f"wait_for_port {port}\n" for port in ports if port in code)
    exports, command = "", code.strip()
    while command.startswith("export "):
        line, _, command = command.partition("\n")
        exports += f"{line}; "
    shell = f"PATH=$LOGIN_PATH; {exports}exec {command}"
    return f"({shell}) >{name}.log 2>&1 &\n{name}=$!\n{waits}"
