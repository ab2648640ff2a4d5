# docker build -t contactdd .                             the default: `docker run --rm contactdd` runs the tests
# docker build -t contactdd-notebook --target notebook .  `docker run --rm -p 8888:8888 contactdd-notebook` serves notebooks
# docker build -t contactdd-env --target environment .    the packages alone: what `run` uses, with the checkout mounted

FROM debian:trixie-slim AS environment
COPY .debian-packages /usr/share/contactdd/
RUN apt-get update \
 && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
      $(sed 's/#.*//' /usr/share/contactdd/.debian-packages) \
 && rm -rf /var/lib/apt/lists/*
# Any user may run the image, also one without an account: a home that everyone can write. MPI's ranks are all in this
# container, perhaps more than it has cores, and root may start them. BLAS threads beyond the free cores only wait.
ENV HOME=/var/cache/contactdd LANG=C.UTF-8 OMP_NUM_THREADS=1 OMPI_MCA_btl=self,sm PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe \
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
RUN mkdir -m 1777 "$HOME"
ENTRYPOINT ["tini", "-g", "--"]

FROM environment AS checkout
COPY . /contactdd
RUN chmod -R a+rwX /contactdd
ENV PYTHONPATH=/contactdd CONTACTDD_RUN=here
WORKDIR /contactdd

FROM checkout AS notebook
EXPOSE 8888
CMD ["jupyter", "notebook", "--allow-root", "--no-browser", "--ip=0.0.0.0", "--port=8888"]

FROM checkout AS test
CMD ["./run", "pytest", "-n", "auto"]
