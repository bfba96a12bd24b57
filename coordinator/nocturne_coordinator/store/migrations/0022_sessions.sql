-- Sessions of the page, known to every process that serves it. Names are kept as hashes: a copy of the database opens none.
CREATE TABLE session (
    sha256 TEXT PRIMARY KEY,
    token TEXT NOT NULL REFERENCES token (name) ON DELETE CASCADE,
    begun REAL NOT NULL
) STRICT;
CREATE INDEX session_begun ON session (begun);
