"""Speed against accuracy: a scene is rendered under everything that trades one for the other, and measured against a reference."""
