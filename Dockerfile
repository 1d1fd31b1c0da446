FROM python:3.12-slim

# One BLAS thread: the matrices are small, and there is a process per core already.
ENV OPENBLAS_NUM_THREADS=1 \
    OMP_NUM_THREADS=1 \
    MKL_NUM_THREADS=1 \
    PYTHONUNBUFFERED=1

RUN useradd --create-home slipfront
WORKDIR /srv/slipfront
COPY pyproject.toml README.md ./
COPY solver solver
COPY app app
COPY static static
# The page opens workbooks, too.
RUN pip install --no-cache-dir ".[excel]"

USER slipfront
# Websockets are accepted from pages of localhost:5006 alone; BOKEH_ALLOW_WS_ORIGIN names others.
EXPOSE 5006
HEALTHCHECK --interval=30s --timeout=5s --start-period=20s \
    CMD ["python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:5006/liveness', timeout=4)"]
CMD ["panel", "serve", "app", "--address", "0.0.0.0", "--port", "5006", "--liveness", "--unused-session-lifetime", "120000", "--session-token-expiration", "86400"]
