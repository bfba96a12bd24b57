"""The coordinator's decisions, all of them pure: no clock, no queue, no database."""
