"""Messages to other services about how renders ended (standardwebhooks.com)."""
