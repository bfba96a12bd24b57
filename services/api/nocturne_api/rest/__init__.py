"""The REST endpoint: FastAPI routers over the operations, and the web page."""
