-- Request ids are their owner's own, and what owners may have is counted. The table is made anew, as SQLite can't
-- drop a column's UNIQUE; long columns stand last, so that lists do not read through them.

CREATE TABLE new_render (
    number INTEGER PRIMARY KEY AUTOINCREMENT,
    id TEXT NOT NULL UNIQUE,
    request_id TEXT NOT NULL,
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
    engine INTEGER NOT NULL,
    -- JSON of Region: which part of the film gets its samples first.
    look_first TEXT NOT NULL DEFAULT '',
    -- How the workers of the render round; empty before its first result.
    floating_point_profile TEXT NOT NULL DEFAULT '',
    -- What its scene, sums and images take of the disk when it is done, at most.
    stored_bytes INTEGER NOT NULL DEFAULT 0,

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
    -- Photons of a render's merged ranges that the tracer's own limits ended.
    truncated_paths INTEGER NOT NULL DEFAULT 0,
    audited INTEGER NOT NULL DEFAULT 0,
    refused INTEGER NOT NULL DEFAULT 0,
    relative_error REAL NOT NULL DEFAULT 0,
    -- How the variance is spread over pixels: see Spread in output/images.py.
    worst_share REAL NOT NULL DEFAULT 0,
    effective_pixels REAL NOT NULL DEFAULT 0,
    predicted_end REAL NOT NULL DEFAULT 0,
    predicted_cpu_seconds REAL NOT NULL DEFAULT 0,
    image_final INTEGER NOT NULL DEFAULT 0 CHECK (image_final IN (0, 1)),

    -- JSON of StopConditions.
    stop TEXT NOT NULL DEFAULT '{}',
    -- A RangeSchedule message.
    schedule BLOB NOT NULL,
    scene_document TEXT NOT NULL
) STRICT;

INSERT INTO new_render (number, id, request_id, request_digest, name, state, reason, owner, priority, sequence,
    width, height, samples, photons_per_sample, scene_sha256, engine, look_first, floating_point_profile,
    created, started, ended, ran_seconds, cpu_seconds, ranges_done, ranges_planned, tiles, tiles_done,
    tiles_failed, photons, rays, photons_per_second, invalid_samples, truncated_paths, audited, refused, relative_error,
    worst_share, effective_pixels, predicted_end, predicted_cpu_seconds, image_final, stop, schedule,
    scene_document)
SELECT number, id, request_id, request_digest, name, state, reason, owner, priority, sequence,
    width, height, samples, photons_per_sample, scene_sha256, engine, look_first, floating_point_profile,
    created, started, ended, ran_seconds, cpu_seconds, ranges_done, ranges_planned, tiles, tiles_done,
    tiles_failed, photons, rays, photons_per_second, invalid_samples, truncated_paths, audited, refused, relative_error,
    worst_share, effective_pixels, predicted_end, predicted_cpu_seconds, image_final, stop, schedule,
    scene_document
FROM render;

-- A number is never given twice, not even one of a render that was deleted.
DELETE FROM sqlite_sequence WHERE name = 'new_render';
INSERT INTO sqlite_sequence (name, seq) SELECT 'new_render', seq FROM sqlite_sequence WHERE name = 'render';

DROP TABLE render;
ALTER TABLE new_render RENAME TO render;

CREATE UNIQUE INDEX render_of_request ON render (owner, request_id);
CREATE INDEX render_open ON render (state) WHERE state IN ('QUEUED', 'RUNNING') OR image_final = 0;
CREATE INDEX render_waiting ON render (owner, priority DESC, number, id) WHERE state = 'QUEUED';
CREATE INDEX render_asked ON render (owner, width, height, samples)
    WHERE state IN ('QUEUED', 'RUNNING', 'PAUSED');
CREATE INDEX render_of_owner ON render (owner);
CREATE INDEX render_stored ON render (owner, stored_bytes);

-- The ends that somebody waits for; who cancels a render knows.
CREATE TRIGGER webhook_of_ended_render AFTER UPDATE OF state ON render
WHEN NEW.state IN ('SUCCEEDED', 'STOPPED_EARLY', 'DEGRADED', 'FAILED') AND OLD.state <> NEW.state
BEGIN
    INSERT INTO webhook_message (webhook_id, message_id, render_id, name, state, reason, unix_time, due)
    SELECT id, 'msg_' || lower(hex(randomblob(16))), NEW.id, NEW.name, NEW.state, NEW.reason, NEW.ended, 0
    FROM webhook WHERE owner = NEW.owner;
END;

CREATE TRIGGER archive_of_final_image AFTER UPDATE OF image_final ON render
WHEN NEW.image_final = 1 AND OLD.image_final = 0
BEGIN
    INSERT INTO archive (render_id, due) VALUES (NEW.id, 0) ON CONFLICT (render_id) DO UPDATE SET due = 0;
END;

-- Who uploaded which file: what counts as stored by whom.
CREATE TABLE upload (
    owner TEXT NOT NULL,
    sha256 TEXT NOT NULL,
    size_bytes INTEGER NOT NULL,
    PRIMARY KEY (owner, sha256)
) STRICT, WITHOUT ROWID;
CREATE INDEX upload_by_content ON upload (sha256);
