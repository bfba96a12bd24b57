-- The type of the scene's sensor, by which whoever shows a render knows what can be asked of it.
ALTER TABLE render ADD COLUMN sensor TEXT NOT NULL DEFAULT '';
UPDATE render SET sensor = coalesce(json_extract(scene_document, '$.sensor.type'), '') WHERE json_valid(scene_document);
