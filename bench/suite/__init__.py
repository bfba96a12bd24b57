"""Error against CPU time: scenes by ways to trace them, against stored references."""
