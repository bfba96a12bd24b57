-- Which render needs which blob: its compiled scene, the files that this and the document name, its layers.
CREATE TABLE blob_use (
    render_id TEXT NOT NULL REFERENCES render (id) ON DELETE CASCADE,
    sha256 TEXT NOT NULL,
    PRIMARY KEY (render_id, sha256)
) STRICT, WITHOUT ROWID;
CREATE INDEX blob_use_by_content ON blob_use (sha256);
-- Files of renders from before are named in their compiled scenes, which SQL can't read: while one of these renders is
-- there, no blob is removed.
INSERT INTO blob_use SELECT id, '' FROM render;
