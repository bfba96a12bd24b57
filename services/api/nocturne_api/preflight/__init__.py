"""The preflight of a scene (what it needs for a target error) runs in a child process."""
