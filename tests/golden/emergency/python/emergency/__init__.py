"""Runs the spindle until somebody presses the emergency button: whatever the law is doing is
abandoned and the brake falls. That it halted is announced when it stands still.
"""
