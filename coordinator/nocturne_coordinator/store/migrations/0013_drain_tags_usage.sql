-- Workers that finish the jobs in hand and get no others, until somebody releases them; by whom asked, Unix time.
CREATE TABLE drain (
    worker_id TEXT PRIMARY KEY,
    who TEXT NOT NULL,
    since REAL NOT NULL
) STRICT;

-- Words that people sort renders by, a JSON list.
ALTER TABLE render ADD COLUMN tags TEXT NOT NULL DEFAULT '[]';

-- What renders that were deleted had used: deleting costs nobody less.
CREATE TABLE deleted_usage (
    owner TEXT PRIMARY KEY,
    renders INTEGER NOT NULL,
    cpu_seconds REAL NOT NULL
) STRICT;
CREATE TRIGGER usage_of_deleted_render AFTER DELETE ON render
BEGIN
    INSERT INTO deleted_usage VALUES (OLD.owner, 1, OLD.cpu_seconds)
    ON CONFLICT (owner) DO UPDATE SET renders = renders + 1, cpu_seconds = cpu_seconds + excluded.cpu_seconds;
END;
