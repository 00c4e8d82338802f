"""The packages: the Python ones, and the OpenCL sources, which are beside them in the checkout and inside ``lumiere`` where it is installed."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["lumiere", "lumiere.*"]), "lumiere.cl"],
    package_dir={"lumiere.cl": "cl"},
    package_data={"lumiere.cl": ["**/*.cl"], "lumiere.doctor": ["data/*"]},
)
