-- Layers are made after a render is queued; these are the ones that still lack them.
CREATE INDEX render_layers_due ON render (number) WHERE layers <> '[]' AND layers_sha256 = '';
