"""Error against CPU time: scenes by method, against stored references."""
