"""Where a render's time goes: ``lumiere profile`` (docs/performance.md)."""
