"""Response times, latencies and reaction times of sampled loops, from stated execution times: is every output ready in
time?
"""
