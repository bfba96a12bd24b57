CREATE TABLE session (
    sha256 words PRIMARY KEY,
    token words NOT NULL REFERENCES token (name) ON DELETE CASCADE,
    begun double precision NOT NULL
);
CREATE INDEX session_begun ON session (begun);
