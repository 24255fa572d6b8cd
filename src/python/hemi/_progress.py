"""Progress bars for progress=True."""


class Bar:
    """Shows phases of long work, one after the other, by tqdm."""

    def __init__(self):
        try:
            from tqdm.auto import tqdm
        except ImportError:
            raise ImportError("progress=True shows bars by tqdm, which is not installed; install it, or pass a "
                              "function of (phase, done, total)") from None
        self._tqdm = tqdm
        self._phase = None
        self._bar = None

    def __call__(self, phase, done, total):
        if phase != self._phase:
            self.close()
            self._phase = phase
            self._bar = self._tqdm(total=total, desc=phase)
        if self._bar is not None:
            self._bar.update(done - self._bar.n)
            if done >= total:
                self.close()

    def close(self):
        if self._bar is not None:
            self._bar.close()
            self._bar = None

    def __del__(self):
        self.close()
