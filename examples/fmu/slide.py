"""The slide of the tutorial as a model of its own, for `pythonfmu build -f slide.py`."""

from pythonfmu import Boolean, Fmi2Causality, Fmi2Slave, Fmi2Variability, Real

SUBSTEPS = 10


class Slide(Fmi2Slave):
    """A slide of 2 kg with friction, a switch at 0 m, and an encoder that counts from where it was switched on."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.start = 0.25
        self.voltage = 0.0
        self.position = 0.0
        self.closed = False
        self.register_variable(
            Real("start", causality=Fmi2Causality.parameter, variability=Fmi2Variability.fixed, start=0.25)
        )
        self.register_variable(Real("voltage", causality=Fmi2Causality.input, start=0.0))
        self.register_variable(Real("position", causality=Fmi2Causality.output))
        self.register_variable(Boolean("closed", causality=Fmi2Causality.output))

    def exit_initialization_mode(self):
        """Begin where `start` says."""
        self.x, self.v = self.start, 0.0
        self._show()

    def do_step(self, current_time, step_size):
        """Integrate the equations of motion, in smaller steps."""
        h = step_size / SUBSTEPS
        for _ in range(SUBSTEPS):
            self.v += h * (5.0 * self.voltage - 20.0 * self.v) / 2.0
            self.x += h * self.v
        self._show()
        return True

    def _show(self):
        self.position = round((self.x - self.start) / 1e-5) * 1e-5
        self.closed = self.x <= 0.0
