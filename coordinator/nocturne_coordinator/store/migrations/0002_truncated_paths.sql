-- Photons of a render's merged ranges that the tracer's own limits ended.
ALTER TABLE render ADD COLUMN truncated_paths INTEGER NOT NULL DEFAULT 0;
