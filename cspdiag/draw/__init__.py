"""Programs → pictures: what is drawn, where it stands, and how it looks."""
