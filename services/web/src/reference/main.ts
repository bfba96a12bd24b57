/** The API reference at /docs: Swagger UI on the service's own description, without anything from elsewhere. */
import SwaggerUI from "swagger-ui-dist/swagger-ui-es-bundle.js";
import "swagger-ui-dist/swagger-ui.css";
import "./reference.css";

SwaggerUI({
  dom_id: "#reference",
  url: "/openapi.json",
  deepLinking: true,
  defaultModelRendering: "example",
  docExpansion: "list",
  // Its badge asks validator.swagger.io.
  validatorUrl: null,
});
