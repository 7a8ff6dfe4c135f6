"""Scenes whose image is known without rendering: each case is a scene, the truth of every pixel, and who can render it."""
