"""Commands that work on this machine: run a service, compile, render, look for missing parts."""
