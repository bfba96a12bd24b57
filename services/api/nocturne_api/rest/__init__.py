"""The REST door: FastAPI routers over the operations."""
