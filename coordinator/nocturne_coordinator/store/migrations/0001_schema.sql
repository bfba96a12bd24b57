-- Tables of a data folder. Times are unix seconds unless a column says otherwise.

CREATE TABLE render (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    request_id TEXT NOT NULL UNIQUE,
    request_digest TEXT NOT NULL,
    name TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN (
        'QUEUED', 'RUNNING', 'PAUSED', 'SUCCEEDED', 'STOPPED_EARLY', 'DEGRADED', 'FAILED', 'CANCELLED'
    )),
    reason TEXT NOT NULL DEFAULT '',
    owner TEXT NOT NULL DEFAULT '',
    priority INTEGER NOT NULL DEFAULT 100,
    -- Grows with every change: what watchers compare.
    sequence INTEGER NOT NULL DEFAULT 1,

    -- What was asked for.
    width INTEGER NOT NULL,
    height INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    photons_per_sample INTEGER NOT NULL DEFAULT 1,
    scene_sha256 TEXT NOT NULL,
    scene_document TEXT NOT NULL,
    engine INTEGER NOT NULL,
    -- A RangeSchedule message.
    schedule BLOB NOT NULL,
    -- JSON of StopConditions.
    stop TEXT NOT NULL DEFAULT '{}',
    -- JSON of Region: which part of the film gets its samples first.
    look_first TEXT NOT NULL DEFAULT '',
    -- How the workers of the render round; empty before its first result.
    floating_point_profile TEXT NOT NULL DEFAULT '',

    -- What is done.
    created REAL NOT NULL,
    started REAL NOT NULL DEFAULT 0,
    ended REAL NOT NULL DEFAULT 0,
    ran_seconds REAL NOT NULL DEFAULT 0,
    cpu_seconds REAL NOT NULL DEFAULT 0,
    ranges_done INTEGER NOT NULL DEFAULT 0,
    ranges_planned INTEGER NOT NULL,
    tiles INTEGER NOT NULL DEFAULT 0,
    tiles_done INTEGER NOT NULL DEFAULT 0,
    tiles_failed INTEGER NOT NULL DEFAULT 0,
    photons INTEGER NOT NULL DEFAULT 0,
    rays INTEGER NOT NULL DEFAULT 0,
    photons_per_second REAL NOT NULL DEFAULT 0,
    invalid_samples INTEGER NOT NULL DEFAULT 0,
    audited INTEGER NOT NULL DEFAULT 0,
    refused INTEGER NOT NULL DEFAULT 0,
    relative_error REAL NOT NULL DEFAULT 0,
    -- How the variance is spread over pixels: see Spread in output/images.py.
    worst_share REAL NOT NULL DEFAULT 0,
    effective_pixels REAL NOT NULL DEFAULT 0,
    predicted_end REAL NOT NULL DEFAULT 0,
    predicted_cpu_seconds REAL NOT NULL DEFAULT 0,
    image_final INTEGER NOT NULL DEFAULT 0 CHECK (image_final IN (0, 1))
) STRICT;
CREATE INDEX render_open ON render (state) WHERE state IN ('QUEUED', 'RUNNING') OR image_final = 0;

-- Sums of X, Y, Z, Y squared and further responses per pixel over samples [0, samples), float64 little
-- endian, row by row.
CREATE TABLE tile (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    samples INTEGER NOT NULL,
    sums BLOB NOT NULL,
    -- A commit gives its tiles the render's sequence as their revision: what is above one changed since it.
    revision INTEGER NOT NULL,
    invalid_samples INTEGER NOT NULL,
    PRIMARY KEY (render_id, tile_index)
) STRICT;
CREATE INDEX tile_by_revision ON tile (render_id, revision, tile_index);

-- Tiles that get no more samples, because this range failed on several workers.
CREATE TABLE failed_tile (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    first_sample INTEGER NOT NULL,
    end_sample INTEGER NOT NULL,
    reason TEXT NOT NULL,
    -- JSON: their names.
    workers TEXT NOT NULL,
    PRIMARY KEY (render_id, tile_index)
) STRICT;

-- Whose work is in a tile's sums.
CREATE TABLE contribution (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    tile_index INTEGER NOT NULL,
    worker_id TEXT NOT NULL,
    PRIMARY KEY (render_id, tile_index, worker_id)
) STRICT, WITHOUT ROWID;
CREATE INDEX contribution_of_worker ON contribution (worker_id);

-- The error at each preview.
CREATE TABLE error_point (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    unix_time REAL NOT NULL,
    photons INTEGER NOT NULL,
    samples REAL NOT NULL,
    relative_error REAL NOT NULL,
    worst_share REAL NOT NULL,
    effective_pixels REAL NOT NULL
) STRICT;
CREATE INDEX error_point_of_render ON error_point (render_id, unix_time);

-- Workers that gave signs of life in the last seconds, as they describe themselves.
CREATE TABLE worker (
    id TEXT PRIMARY KEY,
    engine INTEGER NOT NULL,
    threads INTEGER NOT NULL,
    photons INTEGER NOT NULL,
    rays INTEGER NOT NULL,
    photons_per_second REAL NOT NULL,
    jobs_done INTEGER NOT NULL,
    started REAL NOT NULL,
    seen REAL NOT NULL,
    floating_point_profile TEXT NOT NULL
) STRICT;

-- Workers that joined, left, or were put in quarantine.
CREATE TABLE worker_event (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    unix_time REAL NOT NULL,
    worker_id TEXT NOT NULL,
    what TEXT NOT NULL,
    reason TEXT NOT NULL
) STRICT;

-- What all workers together did, minute by minute.
CREATE TABLE rate_point (
    unix_time REAL PRIMARY KEY,
    threads INTEGER NOT NULL,
    photons_per_second REAL NOT NULL
) STRICT;

-- Workers whose results are not taken any more.
CREATE TABLE quarantine (
    worker_id TEXT PRIMARY KEY,
    reason TEXT NOT NULL,
    since REAL NOT NULL
) STRICT;

-- Increased whenever a coordinator finds no other one; each commit checks that it is still its own.
CREATE TABLE ownership (
    only_row INTEGER PRIMARY KEY CHECK (only_row = 1),
    epoch INTEGER NOT NULL,
    -- Tells one data folder from another, where both are on one Redis by mistake.
    folder TEXT NOT NULL
) STRICT;
INSERT INTO ownership VALUES (1, 0, lower(hex(randomblob(8))));

-- Coordinators that are at work, until a time that they put off again and again.
CREATE TABLE coordinator (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    until REAL NOT NULL
) STRICT;

-- Which coordinator works on a render. The fence grows whenever somebody takes it, or changes its sums from
-- outside; only who knows the newest may write.
CREATE TABLE lease (
    render_id TEXT PRIMARY KEY REFERENCES render (id) ON DELETE CASCADE,
    coordinator INTEGER NOT NULL,
    fence INTEGER NOT NULL
) STRICT;

-- Who traces what just now, as each coordinator sees it of its own renders.
CREATE TABLE at_work (
    coordinator INTEGER NOT NULL,
    render_id TEXT NOT NULL,
    tile_index INTEGER NOT NULL,
    worker_id TEXT NOT NULL,
    PRIMARY KEY (coordinator, render_id, tile_index, worker_id)
) STRICT, WITHOUT ROWID;

-- What coordinators count and measure, for the API to show.
CREATE TABLE meter (
    coordinator INTEGER NOT NULL,
    name TEXT NOT NULL,
    value REAL NOT NULL,
    PRIMARY KEY (coordinator, name)
) STRICT, WITHOUT ROWID;

CREATE TABLE token (
    name TEXT PRIMARY KEY,
    -- SHA-256 of the secret, which is 256 random bits: nothing to guess, so no slow hash.
    sha256 TEXT NOT NULL UNIQUE,
    scopes TEXT NOT NULL,
    weight INTEGER NOT NULL,
    created REAL NOT NULL,
    -- 0: it is not.
    revoked REAL NOT NULL DEFAULT 0
) STRICT;

-- Who changed what.
CREATE TABLE call (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    unix_time REAL NOT NULL,
    who TEXT NOT NULL,
    what TEXT NOT NULL,
    render_id TEXT NOT NULL,
    request_id TEXT NOT NULL,
    outcome TEXT NOT NULL
) STRICT;

-- Addresses that are told how renders end.
CREATE TABLE webhook (
    id TEXT PRIMARY KEY,
    owner TEXT NOT NULL,
    url TEXT NOT NULL,
    -- As it is, for messages are signed with it.
    secret TEXT NOT NULL,
    created REAL NOT NULL,
    last_outcome TEXT NOT NULL DEFAULT ''
) STRICT;

CREATE TABLE webhook_message (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    webhook_id TEXT NOT NULL REFERENCES webhook (id) ON DELETE CASCADE,
    message_id TEXT NOT NULL,
    render_id TEXT NOT NULL,
    name TEXT NOT NULL,
    state TEXT NOT NULL,
    reason TEXT NOT NULL,
    unix_time REAL NOT NULL,
    attempts INTEGER NOT NULL DEFAULT 0,
    -- When it is to be sent; NULL: it was, or never will be.
    due REAL
) STRICT;
CREATE INDEX webhook_message_due ON webhook_message (due) WHERE due IS NOT NULL;

-- The ends that somebody waits for; who cancels a render knows.
CREATE TRIGGER webhook_of_ended_render AFTER UPDATE OF state ON render
WHEN NEW.state IN ('SUCCEEDED', 'STOPPED_EARLY', 'DEGRADED', 'FAILED') AND OLD.state <> NEW.state
BEGIN
    INSERT INTO webhook_message (webhook_id, message_id, render_id, name, state, reason, unix_time, due)
    SELECT id, 'msg_' || lower(hex(randomblob(16))), NEW.id, NEW.name, NEW.state, NEW.reason, NEW.ended, 0
    FROM webhook WHERE owner = NEW.owner;
END;

-- Final images that are in the object store, or are to go there.
CREATE TABLE archive (
    render_id TEXT PRIMARY KEY REFERENCES render (id) ON DELETE CASCADE,
    -- When the images are to be copied; NULL: they were.
    due REAL,
    -- JSON: what is in the object store, by file name.
    files TEXT NOT NULL DEFAULT '{}'
) STRICT;

CREATE TRIGGER archive_of_final_image AFTER UPDATE OF image_final ON render
WHEN NEW.image_final = 1 AND OLD.image_final = 0
BEGIN
    INSERT INTO archive (render_id, due) VALUES (NEW.id, 0) ON CONFLICT (render_id) DO UPDATE SET due = 0;
END;

-- Deleted renders whose files may still be there.
CREATE TABLE removal (
    render_id TEXT PRIMARY KEY,
    -- JSON: digests of the files that it used, perhaps with others.
    files TEXT NOT NULL
) STRICT;
