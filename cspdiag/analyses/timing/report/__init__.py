"""The timing report: latencies, chains and pictures, as text and as JSON."""
