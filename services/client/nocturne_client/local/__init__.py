"""What the command line does on this machine: run a service, compile, render, look for what is missing."""
