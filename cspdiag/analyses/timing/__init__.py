"""Whether every sampled loop has its output in time: response times, latencies, reaction times, from stated execution
times.
"""
