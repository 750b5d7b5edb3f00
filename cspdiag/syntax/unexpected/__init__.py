"""Why a token is not allowed in its place."""
