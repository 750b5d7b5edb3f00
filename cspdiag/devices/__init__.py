"""Devices that ``driver X device "..."`` names: classes like those that users write for their own drivers.

``catalogue`` says what each offers, and is all that the compiler reads. The other modules need nothing of cspdiag,
because generated packages carry copies of those that they use; the libraries behind them are imported when a device is
opened.
"""
