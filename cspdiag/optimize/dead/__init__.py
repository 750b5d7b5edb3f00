"""Dead code elimination."""
