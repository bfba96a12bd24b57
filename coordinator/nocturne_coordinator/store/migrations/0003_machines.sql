-- Machines that enrolled, each by a token; what is revoked with the token is not used any more. Keys must be there in
-- the clear: both sides sign with them.
CREATE TABLE machine (
    name TEXT PRIMARY KEY,
    key BLOB NOT NULL,
    enrolled REAL NOT NULL
) STRICT;

-- Proves that a result is of a job that somebody was given; one row.
CREATE TABLE lease_key (
    number INTEGER PRIMARY KEY CHECK (number = 1),
    key BLOB NOT NULL
) STRICT;
