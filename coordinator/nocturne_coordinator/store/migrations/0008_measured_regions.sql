-- Parts of its image that people measure, kept with the render: JSON of `store/measured_regions.py`.
CREATE TABLE measured_region (
    render_id TEXT PRIMARY KEY REFERENCES render (id) ON DELETE CASCADE,
    regions TEXT NOT NULL
) STRICT;

-- When a worker was first seen with a tile, Unix time.
ALTER TABLE at_work ADD COLUMN since REAL NOT NULL DEFAULT 0;
