-- Renders that were submitted together, and the group that has to end before a render begins; of one owner.
ALTER TABLE render ADD COLUMN in_group TEXT NOT NULL DEFAULT '';
ALTER TABLE render ADD COLUMN after_group TEXT NOT NULL DEFAULT '';
CREATE INDEX render_in_group ON render (owner, in_group) WHERE in_group <> '';
