"""Programs → pictures: what is drawn, where, and how it looks."""
