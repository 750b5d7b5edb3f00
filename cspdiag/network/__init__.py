"""From a typed program to the network: instances, channels, periods, control laws."""
