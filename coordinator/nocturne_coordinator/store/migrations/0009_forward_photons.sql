-- Of renders whose forward photons have ranges of their own (decision 0074) `sums` of a tile are those of both kinds of
-- photons, empty while one has not come, and these: of its own samples, and of the forward photons that fell on it.
ALTER TABLE tile ADD COLUMN own BLOB NOT NULL DEFAULT x'';
ALTER TABLE tile ADD COLUMN photons BLOB NOT NULL DEFAULT x'';
ALTER TABLE render ADD COLUMN photon_bundles INTEGER NOT NULL DEFAULT 0;
