"""Starts a program that the kernel kills when its parent dies, however the parent dies.

    python die_with_parent.py PARENT_PID PROGRAM [ARGUMENT...]

PR_SET_PDEATHSIG survives exec, so this script becomes the program. It imports nothing of the package: it runs
once per child, isolated, and costs some milliseconds.
"""

import ctypes
import os
import signal
import sys

_PR_SET_PDEATHSIG = 1


def main() -> None:
    """Becomes the program; does nothing if the parent is gone already."""
    parent, program = int(sys.argv[1]), sys.argv[2]
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    if os.getppid() == parent:
        os.execv(program, sys.argv[2:])  # noqa: S606 - no shell is the point


if __name__ == "__main__":
    main()
