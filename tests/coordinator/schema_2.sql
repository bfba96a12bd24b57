CREATE TABLE render (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    request_id TEXT NOT NULL UNIQUE,
    request_digest TEXT NOT NULL,
    name TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('QUEUED', 'RUNNING', 'SUCCEEDED', 'FAILED', 'CANCELLED')),
    reason TEXT NOT NULL DEFAULT '',
    width INTEGER NOT NULL,
    height INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    photons_per_sample INTEGER NOT NULL DEFAULT 1,
    scene_sha256 TEXT NOT NULL,
    engine INTEGER NOT NULL,
    sequence INTEGER NOT NULL DEFAULT 1,
    created REAL NOT NULL,
    started REAL NOT NULL DEFAULT 0,
    ended REAL NOT NULL DEFAULT 0,
    ranges_done INTEGER NOT NULL DEFAULT 0,
    ranges_planned INTEGER NOT NULL,
    photons INTEGER NOT NULL DEFAULT 0,
    rays INTEGER NOT NULL DEFAULT 0,
    invalid_samples INTEGER NOT NULL DEFAULT 0,
    relative_error REAL NOT NULL DEFAULT 0,
    photons_per_second REAL NOT NULL DEFAULT 0,
    cpu_seconds REAL NOT NULL DEFAULT 0,
    image_final INTEGER NOT NULL DEFAULT 0 CHECK (image_final IN (0, 1)),
    schedule BLOB NOT NULL,
    scene_document TEXT NOT NULL
) STRICT;
CREATE INDEX render_open ON render (state) WHERE state IN ('QUEUED', 'RUNNING') OR image_final = 0;

-- Sums of X, Y, Z, Y squared and further responses per pixel over samples [0, samples), float64 little
-- endian, row by row.
CREATE TABLE tile (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    sums BLOB NOT NULL,
    PRIMARY KEY (render_id, tile_index)
) STRICT;

CREATE TABLE error_point (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    unix_time REAL NOT NULL,
    photons INTEGER NOT NULL,
    samples REAL NOT NULL,
    relative_error REAL NOT NULL
) STRICT;
CREATE INDEX error_point_of_render ON error_point (render_id, unix_time);

CREATE TABLE worker (
    id TEXT PRIMARY KEY,
    engine INTEGER NOT NULL,
    threads INTEGER NOT NULL,
    photons INTEGER NOT NULL,
    rays INTEGER NOT NULL,
    photons_per_second REAL NOT NULL,
    jobs_done INTEGER NOT NULL,
    started REAL NOT NULL,
    seen REAL NOT NULL
) STRICT;

-- Increased by every coordinator that takes the folder; each commit checks that it is still its own.
CREATE TABLE ownership (
    only_row INTEGER PRIMARY KEY CHECK (only_row = 1),
    epoch INTEGER NOT NULL
) STRICT;
INSERT INTO ownership VALUES (1, 0);
PRAGMA user_version = 2;
