-- Workers that finish the jobs in hand and get no others, until somebody releases them; by whom asked, Unix time.
CREATE TABLE drain (
    worker_id TEXT PRIMARY KEY,
    who TEXT NOT NULL,
    since REAL NOT NULL
) STRICT;
