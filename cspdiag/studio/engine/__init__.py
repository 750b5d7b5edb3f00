"""The engine behind the page: requests and answers as plain data, whatever carries them (docs/design/studio.md)."""
