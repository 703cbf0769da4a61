"""What was found, whether it is right and how fast: `explain`, `check` and `bench`.

    findings    the facts of a derivative as a frozen table
    sizes       the bytes of what is recorded, for concrete arguments
    explain     the table as text, JSON and a page (page: the HTML)
    check       tangent against adjoint, tangent against differences; divergence: where they differ first
    bench       times and errors of derivatives beside differences and the complex step (slopes: the errors)
"""
