-- A warning was its sentence alone, and always of the scene's document or of layers.
UPDATE render SET warnings = (
    SELECT json_group_array(json_object(
        'kind', CASE WHEN value LIKE 'It has no layers: %' THEN 'layers' ELSE 'scene' END,
        'sentence', value, 'parts', json('[]')))
    FROM json_each(render.warnings)) WHERE warnings <> '[]';
