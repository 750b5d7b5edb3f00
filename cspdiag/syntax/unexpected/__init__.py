"""Why a token cannot stand where it stands."""
